"""A sparse network on a coded mask under faults, beside the pipeline that leads there."""
