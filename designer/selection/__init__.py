"""From the continuous optimum to a product that can be bought, proved with its own figures."""
