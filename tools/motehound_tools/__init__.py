"""Reports, sweeps and reference figures for the command `motehound`."""
