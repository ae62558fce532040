"""What was measured on a built machine."""
