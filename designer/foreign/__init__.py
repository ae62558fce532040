"""Robot files of other programs, read into what a study can hold of them."""
