"""The centre of any point-symmetric spot, registered on its mirror image, stage by stage."""
