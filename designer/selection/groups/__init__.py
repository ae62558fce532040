"""A product for each group of cables, so that the machine is lightest."""
