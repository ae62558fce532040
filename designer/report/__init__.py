"""The two documents as data, their figures, and how they become HTML and PDF."""
