"""What notebooks show: levels and environments as pictures, and the robot as it moves."""
