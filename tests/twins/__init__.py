"""Simulated measurements of cable robots, by physics that shares nothing with the product.

``physics`` solves the cable equation by quadrature in 3-D, ``effects`` changes machine and
readings, ``robots`` holds three machines, ``dataset`` makes and writes data sets.
"""
