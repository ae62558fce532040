"""What is proved of a whole region: bounds that hold in every pose, by enclosures over boxes."""
