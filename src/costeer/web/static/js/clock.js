/** The page's clock: the same in the page and in its worker. */

/** Time now [s], since an epoch that all threads of the page share. */
export function now() {
  return (performance.timeOrigin + performance.now()) / 1000;
}
