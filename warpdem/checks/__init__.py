"""What can be said of a scene before it runs: step, overlaps, doubts."""
