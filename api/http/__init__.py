"""Parts of the HTTP service; `api.service` puts them together."""
