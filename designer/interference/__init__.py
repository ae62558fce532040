"""How near cables come to each other and to the platform."""
