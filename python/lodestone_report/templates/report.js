// The report without this script is complete; with it tables sort and filter, pictures enlarge, data can be saved.
'use strict';

const valueOf = (cell) => cell.dataset.v === undefined ? cell.textContent.trim() : Number(cell.dataset.v);
const isEmpty = (value) => value === '' || value === '\u2013';

// Numbers before texts; empty cells come last in either direction.
function compare(a, b, sign) {
  if (isEmpty(a) || isEmpty(b)) return isEmpty(a) - isEmpty(b);
  if (typeof a !== typeof b) return typeof a === 'number' ? -1 : 1;
  return sign * (typeof a === 'number' ? a - b : a.localeCompare(b, 'en', {numeric: true}));
}

function sortBy(table, heading, column) {
  const down = heading.getAttribute('aria-sort') === 'ascending', body = table.tBodies[0];
  for (const other of table.tHead.rows[0].cells) other.setAttribute('aria-sort', 'none');
  heading.setAttribute('aria-sort', down ? 'descending' : 'ascending');
  const rows = [...body.rows].map((row) => [valueOf(row.cells[column]), row]);
  rows.sort((a, b) => compare(a[0], b[0], down ? -1 : 1));
  body.append(...rows.map(([, row]) => row));
}

for (const table of document.querySelectorAll('table.sort')) {
  if (table.tBodies[0].rows.length < 2) continue;
  [...table.tHead.rows[0].cells].forEach((heading, column) => {
    const button = document.createElement('button');
    button.type = 'button';
    button.append(...heading.childNodes);
    heading.append(button);
    heading.setAttribute('aria-sort', 'none');
    button.addEventListener('click', () => sortBy(table, heading, column));
  });
}

// Every word must be somewhere in a row.
for (const table of document.querySelectorAll('table.filter')) {
  const rows = [...table.tBodies[0].rows];
  if (rows.length < 8) continue;
  const bar = document.createElement('div'), input = document.createElement('input'), count = document.createElement('span');
  bar.className = 'filter-bar';
  input.type = 'search';
  input.placeholder = 'Filter rows';
  input.setAttribute('aria-label', `Filter rows: ${table.caption.textContent.trim()}`);
  count.setAttribute('role', 'status');
  bar.append(input, count);
  table.parentElement.before(bar);
  const texts = rows.map((row) => row.textContent.toLowerCase());
  input.addEventListener('input', () => {
    const words = input.value.toLowerCase().split(/\s+/).filter(Boolean);
    let shown = 0;
    rows.forEach((row, k) => {
      row.hidden = !words.every((word) => texts[k].includes(word));
      shown += row.hidden ? 0 : 1;
    });
    count.textContent = words.length ? `${shown} of ${rows.length} rows` : '';
  });
}

const downloads = document.querySelector('.downloads');
downloads.hidden = false;
downloads.addEventListener('click', (event) => {
  const kind = event.target.dataset.save;
  if (!kind) return;
  const data = JSON.parse(document.getElementById(`data-${kind}`).textContent);
  const text = kind === 'csv' ? data : JSON.stringify(data, null, 1) + '\n';
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([text], {type: kind === 'csv' ? 'text/csv' : 'application/json'}));
  link.download = `report.${kind}`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
});

const dialog = document.createElement('dialog'), enlarged = document.createElement('img'), words = document.createElement('p');
dialog.append(enlarged, words);
document.body.append(dialog);
dialog.addEventListener('click', () => dialog.close());
for (const button of document.querySelectorAll('.picture button'))
  button.addEventListener('click', () => {
    const picture = button.querySelector('img');
    enlarged.src = picture.src;
    enlarged.alt = words.textContent = picture.alt;
    dialog.setAttribute('aria-label', picture.alt);
    dialog.showModal();
  });
