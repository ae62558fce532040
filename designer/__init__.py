"""Design exploration for large cable-driven parallel robots."""

__version__ = "0.1.0"
