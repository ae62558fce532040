"""Studies by the hundred: some fields varied, some results kept, in a store that can go on."""
