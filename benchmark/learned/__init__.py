"""Small convolutional networks that read frames: trained with an extra, evaluated without it."""
