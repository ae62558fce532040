"""The thinnest cable that holds a pose: by a loop, by a constrained optimum, by compiled Newton."""
