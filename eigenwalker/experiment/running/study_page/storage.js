// What the browser keeps for a study: small texts under keys. It may refuse, or be full; then false comes back.

const HOUSE = "eigenwalker";

/** The browser's storage, or null where a page must not have it. */
function openStorage() {
  try {
    localStorage.getItem(HOUSE);
    return localStorage;
  } catch {
    return null;
  }
}

/** A part of the storage, under a path of its own. */
export class Shelf {
  constructor(...path) {
    this.path = [HOUSE, ...path].join("/");
    this.storage = openStorage();
  }

  key(name) {
    return `${this.path}/${name}`;
  }

  get(name) {
    return this.storage?.getItem(this.key(name)) ?? null;
  }

  /** Whether it was kept. */
  put(name, text) {
    try {
      this.storage.setItem(this.key(name), text);
      return true;
    } catch {
      return false;
    }
  }

  remove(name) {
    this.storage?.removeItem(this.key(name));
  }

  get names() {
    const start = `${this.path}/`;
    const keys = this.storage ? Object.keys(this.storage) : [];
    return keys.filter((key) => key.startsWith(start)).map((key) => key.slice(start.length));
  }

  /** Call when another window changes what is under a name. */
  watch(name, changed, signal) {
    const listen = ({ key, newValue }) => key === this.key(name) && changed(newValue);
    addEventListener("storage", listen, { signal });
  }

  getJson(name) {
    try {
      return JSON.parse(this.get(name));
    } catch {
      return null;
    }
  }

  putJson(name, value) {
    return this.put(name, JSON.stringify(value));
  }
}
