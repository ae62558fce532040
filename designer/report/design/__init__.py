"""The sections of the report, one file each: what it shows, and how that follows from results."""
