"""One cable: pure functions on arrays, no robot."""
