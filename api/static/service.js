/* The page's only way out: GET requests to the server it came from. */

export class Problem extends Error {
  constructor({ title, status, detail, errors }) {
    super(detail || title);
    Object.assign(this, { title, status, detail, errors: errors ?? [] });
  }
}

/** Path and query; arrays repeat the parameter, empty values are left out. */
export function address(path, query = {}) {
  const parameters = new URLSearchParams();
  for (const [name, value] of Object.entries(query)) {
    for (const one of Array.isArray(value) ? value : [value]) {
      if (one !== null && one !== undefined && one !== "") parameters.append(name, one);
    }
  }
  const text = parameters.toString();
  return text ? `${path}?${text}` : path;
}

export async function getJson(url, signal) {
  let response;
  try {
    response = await fetch(url, { headers: { Accept: "application/json" }, signal });
  } catch (cause) {
    if (cause.name === "AbortError") throw cause;
    throw new Problem({
      title: "The server does not answer",
      detail: `No answer from ${url}. Is "sunatlas serve" still running?`,
    });
  }
  if (response.ok) return response.json();
  const type = response.headers.get("Content-Type") ?? "";
  const body = type.includes("json") ? await response.json() : {};
  throw new Problem({
    title: body.title || response.statusText || "Error",
    status: response.status,
    detail: typeof body.detail === "string" ? body.detail : `${url} was refused.`,
    errors: body.errors,
  });
}

const remembered = new Map();

/** getJson, asked once a visit. A failure is not remembered. */
export function getOnce(url) {
  if (!remembered.has(url)) {
    const asked = getJson(url);
    remembered.set(url, asked);
    asked.catch(() => remembered.delete(url));
  }
  return remembered.get(url);
}
