agent Car { mode Go { } mode Stop { } }
