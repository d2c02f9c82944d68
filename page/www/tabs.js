// Tabs, by mouse and by arrow keys.
'use strict';

const tabs = [...document.querySelectorAll('[role=tab]')];

function show(tab) {
  for (const other of tabs) {
    const isShown = other === tab;
    other.setAttribute('aria-selected', isShown);
    other.tabIndex = isShown ? 0 : -1;
    $(other.getAttribute('aria-controls')).hidden = !isShown;
  }
  terminalShown(tab.id === 'tab-terminal');
  if (tab.id === 'tab-machine') drawEditor();
}

for (const [index, tab] of tabs.entries()) {
  tab.onclick = () => show(tab);
  tab.onkeydown = event => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    const next = tabs[(index + step + tabs.length) % tabs.length];
    next.focus();
    show(next);
  };
}
