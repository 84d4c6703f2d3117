"""Safe interval path planning (SIPP) among dynamic obstacles, on a roadmap."""
