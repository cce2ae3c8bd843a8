"""Parts of the HTTP service; `api.server.app` puts them together."""
