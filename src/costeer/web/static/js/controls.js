/**
 * Controls: hands and feet on keyboard or gamepad.
 *
 * The keys tell only where to; how the arm gets there, and that it feels the guidance, is
 * the server's part.
 */

/** Keys by what they do; `code` is the place on the keyboard, not the letter. */
const STEERING = { ArrowLeft: 1, KeyA: 1, ArrowRight: -1, KeyD: -1 };
const PEDALS = { ArrowUp: "accelerator", ArrowDown: "brake" };

/** Part of a stick's way around the middle that counts as the middle [-]. */
const DEAD_ZONE = 0.06;

/** Whether someone types into a field. */
export function isTyping(target) {
  return target instanceof HTMLElement && Boolean(target.closest("input, select, textarea, button"));
}

export class Controls {
  constructor() {
    this.pressed = new Set();
    this.gamepadIsUsed = false;
    this.mayUseGamepad = true;
    addEventListener("blur", () => this.pressed.clear());
  }

  /**
   * Note a key.
   * @returns {boolean} whether it is one of the driving keys
   */
  key(code, down) {
    // While Cmd is held, macOS tells no other key's release: none is held after it.
    if (!down && /^(Meta|OS)(Left|Right)$/.test(code)) {
      this.pressed.clear();
      return true;
    }
    if (!(code in STEERING) && !(code in PEDALS)) return false;
    if (down) this.pressed.add(code);
    else this.pressed.delete(code);
    return true;
  }

  /** What the keys ask for; left is positive. */
  fromKeys() {
    const controls = { steer: 0, accelerator: 0, brake: 0 };
    for (const code of this.pressed) {
      if (code in STEERING) controls.steer += STEERING[code];
      else controls[PEDALS[code]] = 1;
    }
    controls.steer = Math.max(-1, Math.min(1, controls.steer));
    return controls;
  }

  /** What the first gamepad asks for, or null. Its axis is positive to the right. */
  fromGamepad() {
    if (!this.mayUseGamepad) return null;
    const pad = [...(navigator.getGamepads?.() ?? [])].find((one) => one?.connected);
    if (!pad) return null;
    const raw = -(pad.axes[0] ?? 0);
    const beyond = Math.max(0, Math.abs(raw) - DEAD_ZONE) / (1 - DEAD_ZONE);
    const controls = {
      steer: Math.sign(raw) * beyond + 0,
      accelerator: pad.buttons[7]?.value ?? 0,
      brake: pad.buttons[6]?.value ?? 0,
    };
    const isMoved = beyond > 0 || controls.accelerator > 0 || controls.brake > 0;
    this.gamepadIsUsed ||= isMoved;
    return this.gamepadIsUsed ? controls : null;
  }

  /** The controls now: keys where one is down, else the gamepad. */
  read() {
    const pad = this.pressed.size === 0 ? this.fromGamepad() : null;
    return pad ?? this.fromKeys();
  }
}
