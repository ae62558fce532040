"""One pose: balance of the platform, with straight or with sagging cables."""
