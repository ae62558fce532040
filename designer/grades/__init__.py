"""Rope grades that can be bought: their figures, their checks, and the door they come in by."""
