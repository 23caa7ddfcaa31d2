// Of the report (experiments/report.cpp): what a reader gains with a script; all of the page is there without it.
"use strict";

// Columns of a sortable table: by their fields' data-sort, or by number, or by text.
function sortable(table) {
  const body = table.tBodies[0];
  const headers = [...table.tHead.rows[0].cells];
  const key = (row, column) => row.cells[column].dataset.sort ?? row.cells[column].textContent.trim();
  headers.forEach((header, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...header.childNodes);
    header.append(button);
    button.addEventListener("click", () => {
      const down = header.getAttribute("aria-sort") === "ascending";
      headers.forEach((other) => other.removeAttribute("aria-sort"));
      header.setAttribute("aria-sort", down ? "descending" : "ascending");
      const rows = [...body.rows];
      rows.sort((a, b) => key(a, column).localeCompare(key(b, column), "en", { numeric: true }));
      body.append(...(down ? rows.reverse() : rows));
    });
  });
}

// A choice of verdicts above the table of claims.
function filterable(table) {
  const rows = [...table.tBodies[0].rows];
  const counts = new Map();
  rows.forEach((row) => counts.set(row.dataset.verdict, (counts.get(row.dataset.verdict) ?? 0) + 1));
  const choice = document.createElement("fieldset");
  choice.className = "filter";
  const legend = document.createElement("legend");
  legend.textContent = "Show:";
  choice.append(legend);
  counts.forEach((count, verdict) => {
    const label = document.createElement("label");
    const box = document.createElement("input");
    box.type = "checkbox";
    box.checked = true;
    box.value = verdict;
    label.append(box, ` ${verdict} (${count})`);
    choice.append(label);
  });
  choice.addEventListener("change", () => {
    const shown = new Set([...choice.querySelectorAll("input:checked")].map((box) => box.value));
    rows.forEach((row) => { row.hidden = !shown.has(row.dataset.verdict); });
  });
  table.before(choice);
}

// A link to what is folded away unfolds it.
function unfold() {
  const target = location.hash.length > 1 && document.getElementById(decodeURIComponent(location.hash.slice(1)));
  for (let at = target; at; at = at.parentElement) if (at instanceof HTMLDetailsElement) at.open = true;
  target?.querySelector(":scope > details.fold")?.setAttribute("open", "");
  target?.scrollIntoView();
}

document.querySelectorAll("table.sortable").forEach(sortable);
document.querySelectorAll("table.claims").forEach(filterable);
addEventListener("hashchange", unfold);
addEventListener("beforeprint", () => document.querySelectorAll("details.fold").forEach((fold) => { fold.open = true; }));
unfold();
