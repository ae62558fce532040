"""Measured data against the model: residual, missing effect, error before and after."""
