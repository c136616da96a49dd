// Values where one points, a choice of participants, tables that sort. Without this script
// the page says the same; all numbers stand in its tables and in figures/*.csv.
"use strict";
(() => {
  const text = (value) => String(Number(value.toPrecision(3))).replace("-", "\u2212");
  const make = (name, fields, ...inside) => {
    const made = Object.assign(document.createElement(name), fields);
    made.append(...inside);
    return made;
  };
  const tip = make("div", { className: "tip", hidden: true, ariaHidden: "true" });
  document.body.append(tip);

  // Height of a path at x, interpolated; nothing where it has a gap or is not drawn.
  const heightAt = (d, x) => {
    let before = null;
    for (const [, letter, a, b] of d.matchAll(/([ML])\s*(-?[\d.]+)[\s,]+(-?[\d.]+)/g)) {
      const [px, py] = [Number(a), Number(b)];
      if (letter === "L" && before && before[0] < px && before[0] <= x && x <= px)
        return before[1] + ((py - before[1]) * (x - before[0])) / (px - before[0]);
      before = [px, py];
    }
    return null;
  };
  const pathOf = (svg, name, id) => svg.getElementById(`${name}-${id}`)?.querySelector("path");

  const words = (svg, name, values, x, y) => {
    let [nearest, reach] = [null, 7];
    for (const mark of values.marks) {
      const distance = Math.hypot(mark[0] - x, mark[1] - y);
      if (distance < reach) [nearest, reach] = [mark, distance];
    }
    if (nearest) return [nearest[2]];
    const inside = ({ box: b }) => b[0] <= x && x <= b[2] && b[1] <= y && y <= b[3];
    const number = values.panels.findIndex(inside);
    if (number < 0) return [];
    const { box, x: across, y: up, names } = values.panels[number];
    const at = across[0] + ((x - box[0]) / (box[2] - box[0])) * (across[1] - across[0]);
    const lines = [];
    for (const [id, panel, series] of values.curves) {
      const d = panel === number && pathOf(svg, name, id)?.getAttribute("d");
      const height = d ? heightAt(d, x) : null;
      if (height === null || height < box[1] - 1 || height > box[3] + 1) continue;
      const share = (box[3] - height) / (box[3] - box[1]);
      lines.push(`${series}: ${text(up[0] + share * (up[1] - up[0]))}`);
    }
    return lines.length ? [`${names[0]}: ${text(at)}`, names[1], ...lines] : [];
  };

  const point = (svg, name, values) => {
    const hide = () => { tip.hidden = true; };
    const show = (event) => {
      const place = new DOMPoint(event.clientX, event.clientY)
        .matrixTransform(svg.getScreenCTM().inverse());
      const lines = words(svg, name, values, place.x, place.y);
      tip.hidden = lines.length === 0;
      if (tip.hidden) return;
      tip.textContent = lines.join("\n");
      const [right, below] = [innerWidth - tip.offsetWidth - 8, innerHeight - tip.offsetHeight - 8];
      tip.style.left = `${Math.max(4, Math.min(event.clientX + 14, right))}px`;
      tip.style.top = `${Math.max(4, Math.min(event.clientY + 14, below))}px`;
    };
    svg.addEventListener("pointermove", show);
    svg.addEventListener("pointerdown", show);
    svg.addEventListener("pointerleave", hide);
    addEventListener("scroll", hide, { passive: true });
  };

  const choose = (figure, svg, name, others) => {
    const caption = figure.querySelector("figcaption span");
    const select = make("select", {});
    for (const [place, other] of others.entries()) {
      const selected = other.caption === caption.textContent;
      select.append(new Option(other.name, place, selected, selected));
    }
    select.addEventListener("change", () => {
      const other = others[select.value];
      for (const [id, d] of Object.entries(other.paths)) pathOf(svg, name, id)?.setAttribute("d", d);
      caption.textContent = other.caption;
    });
    figure.prepend(make("label", { className: "choice" }, "Participant ", select));
  };

  for (const script of document.querySelectorAll("figure > script")) {
    const figure = script.parentElement;
    const [svg, name] = [figure.querySelector("svg"), figure.id.replace("figure-", "")];
    const values = JSON.parse(script.textContent);
    point(svg, name, values);
    if (values.others.length > 1) choose(figure, svg, name, values.others);
  }

  const key = (row, column) => {
    const shown = row.cells[column].textContent.trim();
    const number = parseFloat(shown.replace("\u2212", "-").replace(/^[<+[]/, ""));
    return Number.isNaN(number) ? shown : number;
  };
  const compare = (a, b) =>
    typeof a === "number" && typeof b === "number"
      ? a - b
      : (typeof a === "number" ? -1 : 0) - (typeof b === "number" ? -1 : 0)
        || String(a).localeCompare(String(b));
  const sort = (table, column) => {
    const cells = [...table.tHead.rows[0].cells];
    const down = cells[column].ariaSort === "ascending";
    for (const cell of cells) cell.removeAttribute("aria-sort");
    cells[column].setAttribute("aria-sort", down ? "descending" : "ascending");
    const last = (row) => (row.cells[0].textContent === "all" ? 1 : 0);
    const rows = [...table.tBodies[0].rows].sort((a, b) =>
      last(a) - last(b) || (down ? -1 : 1) * compare(key(a, column), key(b, column)));
    table.tBodies[0].append(...rows);
  };
  for (const table of document.querySelectorAll("table:not(.prose)")) {
    const rows = [...table.tBodies[0].rows];
    // A row without a name belongs to the one above it.
    if (rows.length < 3 || rows.some((row) => !row.cells[0].textContent)) continue;
    for (const [column, cell] of [...table.tHead.rows[0].cells].entries()) {
      const button = make("button", { type: "button" }, ...cell.childNodes);
      button.addEventListener("click", () => sort(table, column));
      cell.append(button);
    }
  }
})();
