"""A run as a labelled xarray dataset with units and provenance, and writing it to netCDF or CSV."""
