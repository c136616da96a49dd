// Names that the theme leaves out, for readers who hear the page.
const giveNames = () => {
  document.querySelector(".md-search")?.setAttribute("aria-label", "Search");
  document.querySelectorAll(".md-code__nav").forEach((nav, place) => {
    nav.setAttribute("aria-label", `Code block ${place + 1}`);
  });
};
giveNames();
new MutationObserver(giveNames).observe(document.body, { childList: true, subtree: true });
