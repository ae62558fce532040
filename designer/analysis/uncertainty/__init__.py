"""How likely a size is enough where inputs are not certain, and which of them it hangs on."""
