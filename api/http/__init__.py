"""Parts of the HTTP service; `api.http.service` puts them together."""
