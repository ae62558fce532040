"""Values: robot, cable, region, space, verdict, measured data, the machine as it is built."""
