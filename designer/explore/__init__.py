"""Finding a design by hand: a study that is edited, and answers that follow."""
