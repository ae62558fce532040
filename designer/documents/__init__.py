"""Files that a user writes in YAML: lines, fields with units, bounds, faults in one line."""
