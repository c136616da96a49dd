/** Words of a page: texts with places such as `{count}` that are filled when shown. */

/**
 * The words of a key; the key itself where there are none, so that nothing is blank.
 * @param {Record<string, string>} texts
 * @param {string} key
 * @param {Record<string, unknown>} values what stands in for `{name}`
 */
export function words(texts, key, values = {}) {
  const text = texts[key] ?? key;
  return text.replace(/\{(\w+)\}/g, (whole, name) => String(values[name] ?? whole));
}
