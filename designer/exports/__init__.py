"""Studies for other programs: a format a file, over one description of the robot at its poses."""
