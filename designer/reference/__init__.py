"""Numbers of others that this package reproduces: theirs, their source, and how to get ours."""
