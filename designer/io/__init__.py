"""What is read and written: config, JSON, CSV, output folders."""
