pounding: --out: folder /proc/x: cannot be written (No such file or directory); choose another
