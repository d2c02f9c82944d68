"""Every control of a page is used, each in its own way, and nothing complains.

The controls are used by a script between two frames: each redraws the picture, which takes a second in software. Real keys,
fingers and pointers are other trials'.
"""

from chromium import check

# More uses than this mean that each makes a new control.
MOST = 400

# Uses what is seen in an element, also what appears meanwhile; returns the names. A legend is made again after a choice in
# it, so a control is known by its kind, its name without figures, and its place among those of that name. A file chooser
# opens a window of the system.
USE = """const [root, most, done] = arguments, used = new Set(), names = [];
    const keys = ['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', 'Home', 'End', '+', '-', '0', '3', '3', 'Enter', ' ', ' '];
    const say = (control, ...kinds) => kinds.forEach(kind => control.dispatchEvent(new Event(kind, { bubbles: true })));
    const fill = (control, value) => { control.value = value; say(control, 'input', 'change'); };
    function use(control) {
        const { localName: tag, type } = control;
        if (tag === 'select') for (const { value } of [...control.options, control.options[0]]) fill(control, value);
        else if (type === 'checkbox') [0, 1].forEach(() => control.click());
        else if (type === 'range') for (const value of [control.min, control.max]) fill(control, value);
        else if (tag === 'button' || tag === 'summary') control.click();
        else if (tag === 'input' || tag === 'textarea') for (const value of [control.value + '1', control.value]) fill(control, value);
        else for (const key of keys) control.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true, cancelable: true }));
    }
    function next() {
        const seen = new Map();
        for (const control of root.querySelectorAll('button, input, select, textarea, summary, [tabindex="0"]')) {
            if (!control.checkVisibility({ visibilityProperty: true }) || control.disabled || control.type === 'file') continue;
            const label = control.getAttribute('aria-label') || control.labels?.[0]?.textContent || control.textContent || control.title;
            const kind = `${control.localName} ${control.type ?? ''} ${label.trim().replace(/[\\d.,:]+.*/, '')}`;
            seen.set(kind, (seen.get(kind) ?? 0) + 1);
            const known = `${kind} ${seen.get(kind)}`;
            if (used.has(known)) continue;
            used.add(known);
            names.push(label.trim());
            return control;
        }
        return null;
    }
    (async () => {
        for (let control; (control = next()) && names.length < most;) { use(control); await null; }
        requestAnimationFrame(() => requestAnimationFrame(() => done(names)));
    })();"""


def use_all(browser, selector, least):
    """Uses every control within an element; returns how many."""
    names = browser.driver.execute_async_script(USE, browser.find(selector), MOST)
    check(least <= len(names) < MOST, f"{len(names)} controls, {least} at least: {names}")
    browser.check_quiet()
    return len(names)
