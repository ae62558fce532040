"""Compiled arithmetic that encloses: boxes of poses, and what cables do in all of a box."""
