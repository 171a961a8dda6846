// What has changed in the state: see `editor/differences.py`.

/** Return a value with changes; what they leave is shared. @param {any} value @param {any} changes @returns {any} */
export function changed(value, changes) {
  if (Array.isArray(changes)) {
    if (changes.length === 1) return changes[0];
    const [first, stop, part] = changes;
    return value.slice(0, first).concat(part, value.slice(stop));
  }
  const made = Array.isArray(value) ? [...value] : { ...value };
  for (const [name, inner] of Object.entries(changes)) {
    if (Array.isArray(inner) && inner.length === 0) delete made[name];
    else made[name] = changed(value[name], inner);
  }
  return made;
}
