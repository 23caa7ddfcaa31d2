#!/usr/bin/env python3
"""Links every NUMBER.frag of a folder with its NUMBER.vert in an OpenGL context of the driver that the environment chooses, without a
window. What the driver says of each goes to standard error behind a line "=== NUMBER". chip_code.py starts it.
Usage: compile_programs.py FOLDER"""
import ctypes
import os
import pathlib
import sys

EGL_PLATFORM_GBM, EGL_OPENGL_API = 0x31D7, 0x30A2
GL_RENDERER, GL_VERSION = 0x1F01, 0x1F02
GL_FRAGMENT_SHADER, GL_VERTEX_SHADER, GL_LINK_STATUS = 0x8B30, 0x8B31, 0x8B82
GL_DEBUG_OUTPUT, GL_DEBUG_OUTPUT_SYNCHRONOUS = 0x92E0, 0x8242
text, number, whole, pointer = ctypes.c_char_p, ctypes.c_uint, ctypes.c_int, ctypes.c_void_p
DEBUG_CALLBACK = ctypes.CFUNCTYPE(None, number, number, number, number, whole, text, pointer)


def say(words):
    os.write(2, words.encode() + b"\n")


class Context:
    def __init__(self, node="/dev/dri/renderD128"):
        self.egl, gbm = ctypes.CDLL("libEGL.so.1"), ctypes.CDLL("libgbm.so.1")
        self.egl.eglGetProcAddress.restype = pointer
        gbm.gbm_create_device.restype = pointer
        self.egl.eglGetPlatformDisplay.restype = self.egl.eglCreateContext.restype = pointer
        self.egl.eglGetPlatformDisplay.argtypes = [number, pointer, pointer]
        self.egl.eglInitialize.argtypes = [pointer] * 3
        self.egl.eglCreateContext.argtypes = self.egl.eglMakeCurrent.argtypes = [pointer] * 4
        display = self.egl.eglGetPlatformDisplay(EGL_PLATFORM_GBM, gbm.gbm_create_device(os.open(node, os.O_RDWR)), None)
        if not self.egl.eglInitialize(display, None, None):
            sys.exit("eglInitialize failed: the driver doesn't take this device")
        self.egl.eglBindAPI(EGL_OPENGL_API)
        context = self.egl.eglCreateContext(display, None, None, None)
        if not context or not self.egl.eglMakeCurrent(display, None, None, context):
            sys.exit("no OpenGL context of this device")
        self.callback = DEBUG_CALLBACK(lambda _, kind, name, severity, length, message, more: say("message: " + message.decode()))
        self.function("glEnable", None, number)(GL_DEBUG_OUTPUT)
        self.function("glEnable", None, number)(GL_DEBUG_OUTPUT_SYNCHRONOUS)
        self.function("glDebugMessageCallbackKHR", None, DEBUG_CALLBACK, pointer)(self.callback, None)

    def function(self, name, result, *arguments):
        return ctypes.CFUNCTYPE(result, *arguments)(self.egl.eglGetProcAddress(name.encode()))

    def string(self, name):
        return self.function("glGetString", text, number)(name).decode()

    def log_of(self, kind, name):
        log = ctypes.create_string_buffer(8000)
        self.function(f"glGet{kind}InfoLog", None, number, whole, pointer, text)(name, len(log), None, log)
        return log.value.decode()

    def link(self, stages):
        """stages: (kind, text) each. What is wrong with them."""
        program, wrong = self.function("glCreateProgram", number)(), ""
        for kind, source in stages:
            shader = self.function("glCreateShader", number, number)(kind)
            lines = text(source.encode())
            self.function("glShaderSource", None, number, whole, ctypes.POINTER(text), pointer)(shader, 1, ctypes.byref(lines), None)
            self.function("glCompileShader", None, number)(shader)
            wrong += self.log_of("Shader", shader)
            self.function("glAttachShader", None, number, number)(program, shader)
        self.function("glLinkProgram", None, number)(program)
        linked = whole()
        self.function("glGetProgramiv", None, number, number, ctypes.POINTER(whole))(program, GL_LINK_STATUS, ctypes.byref(linked))
        return "" if linked.value else wrong + self.log_of("Program", program)


def main():
    context = Context()
    say(f"renderer: {context.string(GL_RENDERER)}")
    say(f"version: {context.string(GL_VERSION)}")
    for path in sorted(pathlib.Path(sys.argv[1]).glob("*.frag"), key=lambda path: int(path.stem)):
        say(f"=== {path.stem}")
        wrong = context.link([(GL_VERTEX_SHADER, path.with_suffix(".vert").read_text()), (GL_FRAGMENT_SHADER, path.read_text())])
        if wrong:
            say("wrong: " + " | ".join(wrong.split("\n")))


if __name__ == "__main__":
    main()
