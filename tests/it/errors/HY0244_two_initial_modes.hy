agent Car { initial mode Go { } initial mode Stop { } }
