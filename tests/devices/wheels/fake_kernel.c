/* A steering wheel as Linux would show it, for tests without one: loaded before libc,
 * it answers the event-device ioctls on one FIFO and logs every force.
 *
 * FAKE_WHEEL_NODE  the FIFO, shown as /dev/input/event0; input events that are
 *                  written into it move the wheel
 * FAKE_WHEEL_LOG   every effect, every start or stop, every erasure, one a line
 * FAKE_WHEEL_AT    a file with the steering's value when the device is opened, if it is
 *                  not in the middle
 * FAKE_WHEEL_GONE  once this file exists, reads and effects fail as if unplugged
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <linux/input.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

/* SDL looks for forces at these places only. */
static const char *place(const char *path) {
    const char *node = getenv("FAKE_WHEEL_NODE");
    return node && path && strcmp(path, "/dev/input/event0") == 0 ? node : path;
}

static int is_wheel(int fd) {
    struct stat node, other;
    const char *path = getenv("FAKE_WHEEL_NODE");
    return path && fstat(fd, &other) == 0 && S_ISFIFO(other.st_mode) &&
           stat(path, &node) == 0 && node.st_ino == other.st_ino;
}

static int is_gone(void) {
    const char *path = getenv("FAKE_WHEEL_GONE");
    return path && access(path, F_OK) == 0;
}

static int stands_at(void) {
    const char *path = getenv("FAKE_WHEEL_AT");
    FILE *file = path ? fopen(path, "r") : NULL;
    int value = 32768;
    if (!file) return value;
    if (fscanf(file, "%d", &value) != 1) value = 32768;
    fclose(file);
    return value;
}

static void note(const char *format, ...) {
    FILE *log = fopen(getenv("FAKE_WHEEL_LOG"), "a");
    va_list values;
    if (!log) return;
    va_start(values, format);
    vfprintf(log, format, values);
    va_end(values);
    fclose(log);
}

static void set_bit(unsigned char *bits, int bit, size_t size) {
    if ((size_t)bit / 8 < size) bits[bit / 8] |= 1 << (bit % 8);
}

static void capabilities(int kind, unsigned char *bits, size_t size) {
    static const int axes[] = {ABS_X, ABS_Y, ABS_Z, ABS_RZ};
    static const int forces[] = {FF_CONSTANT, FF_SPRING, FF_DAMPER,
                                 FF_FRICTION, FF_GAIN, FF_AUTOCENTER};
    memset(bits, 0, size);
    if (kind == 0) {
        set_bit(bits, EV_KEY, size);
        set_bit(bits, EV_ABS, size);
        set_bit(bits, EV_FF, size);
    } else if (kind == EV_KEY) {
        for (int button = 0; button < 16; button++)
            set_bit(bits, BTN_JOYSTICK + button, size);
    } else if (kind == EV_ABS) {
        for (int n = 0; n < 4; n++) set_bit(bits, axes[n], size);
    } else if (kind == EV_FF) {
        for (int n = 0; n < 6; n++) set_bit(bits, forces[n], size);
    }
}

static int next = 0; /* number of the next effect; an erased one's is used again */

static int upload(struct ff_effect *effect) {
    if (is_gone()) {
        errno = ENODEV;
        return -1;
    }
    if (effect->id < 0) effect->id = next++;
    note("effect id=%d type=0x%x level=%d direction=0x%x length=%d delay=%d "
         "attack=%d fade=%d\n",
         effect->id, effect->type, effect->u.constant.level, effect->direction,
         effect->replay.length, effect->replay.delay,
         effect->u.constant.envelope.attack_length,
         effect->u.constant.envelope.fade_length);
    return 0;
}

static int answer(unsigned int number, size_t size, void *out) {
    static const struct input_id identity = {BUS_USB, 0x046d, 0xc24f, 0x0111};
    if (number == _IOC_NR(EVIOCGID)) {
        memcpy(out, &identity, sizeof identity);
    } else if (number == _IOC_NR(EVIOCGNAME(0))) {
        strncpy(out, "Wheel that is not there", size);
    } else if (number >= 0x20 && number < 0x40) {
        capabilities(number - 0x20, out, size);
    } else if (number >= 0x40 && number < 0x80) {
        int steering = number == 0x40 + ABS_X;
        struct input_absinfo axis = {steering ? stands_at() : 255, 0,
                                     steering ? 65535 : 255, 0, 0, 0};
        memcpy(out, &axis, sizeof axis);
    } else if (number == _IOC_NR(EVIOCSFF)) {
        return upload(out);
    } else if (number == _IOC_NR(EVIOCRMFF)) {
        next = (int)(long)out;
        note("erase id=%d\n", next);
    } else if (number == _IOC_NR(EVIOCGEFFECTS)) {
        *(int *)out = 16;
    } else if (number == _IOC_NR(EVIOCGKEY(0)) || number == _IOC_NR(EVIOCGPROP(0))) {
        memset(out, 0, size);
    } else {
        errno = ENOENT;
        return -1;
    }
    return (int)size;
}

/* What `stat` is in libraries that were linked long ago. */
int __xstat(int version, const char *path, struct stat *out) {
    static int (*real)(int, const char *, struct stat *);
    if (!real) real = dlsym(RTLD_NEXT, "__xstat");
    return real(version, place(path), out);
}

int open64(const char *path, int flags, ...) {
    static int (*real)(const char *, int, ...);
    va_list rest;
    int mode;
    va_start(rest, flags);
    mode = va_arg(rest, int);
    va_end(rest);
    if (!real) real = dlsym(RTLD_NEXT, "open64");
    return real(place(path), flags, mode);
}

int open(const char *path, int flags, ...) {
    static int (*real)(const char *, int, ...);
    va_list rest;
    int mode;
    va_start(rest, flags);
    mode = va_arg(rest, int);
    va_end(rest);
    if (!real) real = dlsym(RTLD_NEXT, "open");
    return real(place(path), flags, mode);
}

int ioctl(int fd, unsigned long request, ...) {
    static int (*real)(int, unsigned long, ...);
    va_list rest;
    void *out;
    va_start(rest, request);
    out = va_arg(rest, void *);
    va_end(rest);
    if (!real) real = dlsym(RTLD_NEXT, "ioctl");
    if (_IOC_TYPE(request) != 'E' || !is_wheel(fd)) return real(fd, request, out);
    return answer(_IOC_NR(request), _IOC_SIZE(request), out);
}

ssize_t write(int fd, const void *content, size_t size) {
    static ssize_t (*real)(int, const void *, size_t);
    const struct input_event *event = content;
    if (!real) real = dlsym(RTLD_NEXT, "write");
    if (size == sizeof *event && event->type == EV_FF && is_wheel(fd)) {
        note("force code=0x%x value=%d\n", event->code, event->value);
        return (ssize_t)size;
    }
    return real(fd, content, size);
}

ssize_t read(int fd, void *content, size_t size) {
    static ssize_t (*real)(int, void *, size_t);
    if (!real) real = dlsym(RTLD_NEXT, "read");
    if (is_wheel(fd) && is_gone()) {
        errno = ENODEV;
        return -1;
    }
    return real(fd, content, size);
}
