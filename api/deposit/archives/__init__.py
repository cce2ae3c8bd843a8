"""Uploading the bundle to an archive that runs InvenioRDM, as Zenodo does."""
