"""All poses: samples of a region, the sweep over them, and the continuous search for the worst."""
